cimport cython
from libc.math cimport floor, isnan

cdef double INFINITY


@cython.locals(
    last=Py_ssize_t, tried=Py_ssize_t, n=Py_ssize_t, k=Py_ssize_t, j=Py_ssize_t, best=double, way=double,
    lowest=double, place=double, x=double,
)
cpdef void least_beside(
    const double[::1] ease_off, const double[::1] curvature, const double[::1] skew, const double[::1] step,
    const double[::1] reach, const double[::1] sample, double steps_per_rotation, double per_cycle, double kept,
    const double[::1] error, Py_ssize_t rounds, double[::1] least,
) noexcept nogil
