cimport cython
from libc.math cimport ilogb, isfinite, ldexp, sqrt

cdef double INFINITY, CANCELLATION_FLOOR, UNIT_ROUNDOFF, SPLITTER, UNDERFLOW, ERROR_FREE, PLAIN
cdef int MAX_CHANGES, MAX_WINKLER_STEPS

cdef double _product_error(double one, double other, double product) noexcept nogil

@cython.locals(rest=double)
cdef bint _shift(
    const double[::1] separation, const double[::1] arm, Py_ssize_t first, double[::1] shifted
) noexcept nogil

@cython.locals(
    least=double, first=Py_ssize_t, other=Py_ssize_t, error=double, touching=double, lever=double, rotation=double,
    turned=double,
)
cpdef (double, double, double) first_contact(
    const double[::1] separation, const double[::1] arm, double[::1] shifted
) noexcept nogil

@cython.locals(top=double, bottom=double, rotation=double, turned=double)
cpdef double winkler_rotation(
    const double[::1] stiff, const double[::1] separation, const double[::1] arm, Py_ssize_t total, double torque
) noexcept nogil

@cython.locals(
    size=Py_ssize_t, finite=bint, total=double, moment=double, size_of_moment=double, strain=double, work=double,
    preload=double, rooted=double, largest=double, least_force=double, far=double, softest=double, longest=double,
    scale=double, cancellation=double, mean=double, uncancelled=double, penetration=double, shared=double,
    unknown=double,
)
cpdef void certificate(
    const double[::1] force, const double[::1] deflection, const double[::1] gap, const double[::1] shifted,
    const double[::1] arm, const double[::1] diagonal, double torque, double terms, double shift_error,
    double[::1] numbers,
) noexcept nogil

cdef double _relative(double error, double scale) noexcept nogil
