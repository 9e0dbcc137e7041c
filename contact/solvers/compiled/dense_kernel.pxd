cimport cython
from libc.math cimport ilogb, ldexp
from libc.stdint cimport int64_t

from .block_algebra cimport backward, dot, eliminate, forward, row_products
from .proof_kernel cimport certificate, first_contact, winkler_rotation

cdef double NAN, SIGN_TOLERANCE, SMALLEST_PIVOT, WINKLER_ROW_SUM_FRACTION
cdef int MAX_STEPS


cdef class Touching:
    cdef const double[::1] matrix, arm
    cdef Py_ssize_t size, count, padded
    cdef double scale
    cdef double[::1] shifted, diagonal, deflection, lever, right, gram, force, gap
    cdef int64_t[::1] touching, index


@cython.locals(row_sum=double, rotation=double)
cdef void _begin(Touching n, double torque) noexcept nogil

@cython.locals(padded=Py_ssize_t, inverse=double)
cdef double _factor(Touching n) noexcept nogil

@cython.locals(turn=double, rotation=double)
cdef double _balance(Touching n, double torque, double pivot) noexcept nogil

cdef void _gaps(Touching n, double rotation) noexcept nogil

@cython.locals(largest=double, far=double, moved=Py_ssize_t)
cdef Py_ssize_t _exchange(Touching n, double rotation, double tolerance) noexcept nogil

@cython.locals(step=Py_ssize_t, pivot=double, rotation=double, left=double, refined=Py_ssize_t)
cdef (Py_ssize_t, double) _solve(Touching n, double torque) noexcept nogil

@cython.locals(n=Touching, side=Py_ssize_t, steps=Py_ssize_t, rotation=double, negative=bint, largest=double)
cpdef Py_ssize_t solve_dense(
    const double[::1] matrix, Py_ssize_t columns, double torque, const double[::1] separation,
    const double[::1] arm, bint started,
    double[::1] room, int64_t[::1] places, double[::1] force, double[::1] gap, double[::1] numbers,
)
