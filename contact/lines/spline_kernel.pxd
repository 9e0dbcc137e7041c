cimport cython
from libc.stdint cimport int64_t


@cython.locals(i=Py_ssize_t, parts=Py_ssize_t, last=Py_ssize_t, part=Py_ssize_t)
cdef Py_ssize_t _interval(
    const double[::1] ends, const int64_t[::1] first, double per_length, double x
) noexcept nogil

@cython.locals(s="double[6]", scale=double)
cdef void _b_splines(
    const double[:, :, :, ::1] pieces, Py_ssize_t i, double u, double unit,
    Py_ssize_t orders, double* values,
) noexcept nogil

@cython.locals(along="double[36]", across="double[36]", sums="double[36]", s="double[6]", most_t=Py_ssize_t, most_h=Py_ssize_t, d=Py_ssize_t, n=Py_ssize_t)
cpdef void evaluate(
    const double[::1] ends_t, const int64_t[::1] first_t, const double[:, ::1] local_t,
    const double[:, :, :, ::1] pieces_t, const double[::1] ends_h, const int64_t[::1] first_h,
    const double[:, ::1] local_h, const double[:, :, :, ::1] pieces_h, const double[:, :, ::1] coefficients,
    const double[::1] t, const double[::1] h, const int64_t[:, ::1] orders,
    double[:, :, ::1] results,
) noexcept nogil
