cimport cython
from libc.math cimport asinh, log, sqrt
from libc.stdint cimport int64_t

cdef int MAX_INVERSION_STEPS
cdef double INVERSION_TOLERANCE
cdef double NEAR

@cython.locals(before=bint, secant=double, tangent=double, logarithm=double, gained=double)
cpdef (double, double) strip(const double[:, ::1] law, Py_ssize_t i, double load) noexcept nogil

cpdef (double, double) pressed(const double[:, ::1] law, Py_ssize_t i, double indentation, double guess) noexcept nogil

@cython.locals(root=double, length=double, tangent=double)
cdef double tangent_root(const double[:, ::1] law, Py_ssize_t i, double force) noexcept nogil

@cython.locals(k=Py_ssize_t)
cpdef void deflections(
    const double[:, ::1] law, const int64_t[::1] segment, const double[::1] load, double[:, ::1] slopes
) noexcept nogil
