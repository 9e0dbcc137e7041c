cimport cython
from libc.stdint cimport int64_t

cdef Py_ssize_t _root(const int64_t[::1] parent, Py_ssize_t column) noexcept nogil

@cython.locals(
    size=Py_ssize_t, width=Py_ssize_t, blocks=Py_ssize_t, zeros=Py_ssize_t, left=Py_ssize_t, first=Py_ssize_t,
    entries=Py_ssize_t, other=Py_ssize_t, across=Py_ssize_t, most=Py_ssize_t,
)
cpdef (Py_ssize_t, bint) label_blocks(
    const double[:, ::1] factor, int64_t[::1] row, int64_t[::1] column, int64_t[::1] rows, int64_t[::1] filled,
    int64_t[::1] parent, int64_t[::1] number,
) noexcept nogil

cpdef void arrange(
    const int64_t[:] segments, const double[:, :] modes, const double[:, :] shared, Py_ssize_t begin,
    Py_ssize_t step, Py_ssize_t count, Py_ssize_t place, Py_ssize_t entry, int64_t[::1] order,
    double[::1] columns,
) noexcept nogil
