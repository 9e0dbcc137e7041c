cimport cython
from libc.math cimport sqrt
from libc.stdint cimport int64_t

cdef double INFINITY

cdef Py_ssize_t _root(const int64_t[::1] parent, Py_ssize_t column) noexcept nogil

@cython.locals(
    size=Py_ssize_t, width=Py_ssize_t, entries=Py_ssize_t, area=Py_ssize_t, blocks=Py_ssize_t, zeros=Py_ssize_t,
    first=Py_ssize_t, other=Py_ssize_t,
)
cpdef (Py_ssize_t, bint) label_blocks(
    const double[:, ::1] factor, int64_t[::1] row, int64_t[::1] column, int64_t[::1] rows, int64_t[::1] parent,
    int64_t[::1] number,
) noexcept nogil

@cython.locals(largest=double, least=double, pivot=Py_ssize_t, rank=Py_ssize_t, root=double)
cdef Py_ssize_t _pivoted(
    const double[::1] block, Py_ssize_t size, Py_ssize_t width, Py_ssize_t most, double tolerance, double[::1] left,
    double[::1] modes,
) noexcept nogil

@cython.locals(s="double[4]")
cdef double _dot(const double[::1] block, Py_ssize_t first, Py_ssize_t second, Py_ssize_t length) noexcept nogil

@cython.locals(s="double[16]", k=Py_ssize_t, x=Py_ssize_t, lane=Py_ssize_t)
cdef void _rows(
    const double[::1] block, Py_ssize_t size, Py_ssize_t width, Py_ssize_t other, double[::1] result, Py_ssize_t out
) noexcept nogil

@cython.locals(size=Py_ssize_t, count=Py_ssize_t, across=Py_ssize_t, padded=Py_ssize_t)
cpdef (Py_ssize_t, Py_ssize_t) compress(
    const double[:, ::1] factor, const int64_t[::1] row, const int64_t[::1] column, Py_ssize_t q, Py_ssize_t most,
    double tolerance, int64_t[::1] index, int64_t[::1] chosen, double[::1] room, double[::1] modes,
) noexcept nogil

cpdef void arrange(
    const int64_t[:] segments, const double[:, :] modes, const double[:, :] shared, Py_ssize_t begin,
    Py_ssize_t step, Py_ssize_t count, Py_ssize_t place, Py_ssize_t entry, int64_t[::1] order,
    double[::1] columns,
) noexcept nogil
