cimport cython
from libc.math cimport asinh, log, sqrt

cdef int MAX_INVERSION_STEPS
cdef double INVERSION_TOLERANCE
cdef double NEAR

@cython.locals(before=bint, secant=double, tangent=double, logarithm=double, gained=double)
cpdef (double, double) strip(const double[:, ::1] law, Py_ssize_t i, double load) noexcept nogil

cpdef (double, double) pressed(const double[:, ::1] law, Py_ssize_t i, double indentation, double guess) noexcept nogil
