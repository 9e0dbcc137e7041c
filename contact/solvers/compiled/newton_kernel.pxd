cimport cython
from libc.math cimport isfinite, sqrt
from libc.stdint cimport int64_t

from .block_algebra cimport add_rows, backward, dot, eliminate, forward, gram, products, row_products
from .line_deflection cimport pressed, strip, tangent_root
from .proof_kernel cimport certificate, first_contact, winkler_rotation

cdef double INFINITY, NAN, ROUNDING_RESIDUAL, STALLED_RESIDUAL, ROUNDING_SLOPE, COARSE_RESIDUAL
cdef double WINKLER_ROW_SUM_FRACTION, TOUCHING_GUESS
cdef int MAX_ITERATIONS, MAX_HALVINGS, MAX_COARSE_ITERATIONS


cdef class Newton:
    cdef const double[::1] columns, mixing
    cdef const double[:, ::1] law, sums
    cdef const int64_t[::1] places, order
    cdef const int64_t[:, ::1] table
    cdef Py_ssize_t blocks, level, size, local_shared, shared, padded_shared, width, modes, mixed_stride
    cdef bint plain
    cdef double[::1] amplitudes, loads, change, begin, best, border, solved, mixed, stiff_mixed
    cdef double[::1] shifted, separation, arm, stiff, gap, root, pull, lever, force, local
    cdef double[::1] z, grams, rows, few, whole, pool, given
    cdef Py_ssize_t taken
    cdef int64_t[::1] spans, segment, touching


@cython.locals(matrix=Py_ssize_t, few=Py_ssize_t, mixed=Py_ssize_t,
               zeros=Py_ssize_t, whole=Py_ssize_t)
cdef void _prepare(Newton n, tuple modes, object law, Py_ssize_t size)

cdef double[::1] _room(Newton n, Py_ssize_t size)
cdef Py_ssize_t _padded(Py_ssize_t size) noexcept nogil

@cython.locals(count=Py_ssize_t)
cdef Py_ssize_t _count(Newton n, Py_ssize_t q) noexcept nogil
cdef void _spread(Newton n, double[::1] vector) noexcept nogil
cdef void _gather(Newton n) noexcept nogil

@cython.locals(moment=double, pivot=double, changed=bint, different=bint, low=Py_ssize_t, high=Py_ssize_t)
cdef (double, double, bint) _point(Newton n, double rotation, bint linear) noexcept nogil

cdef (double, double) _loads_of(Newton n, Py_ssize_t q, double moment, double pivot) noexcept nogil

@cython.locals(place=Py_ssize_t)
cdef void _fill(Newton n, Py_ssize_t q, Py_ssize_t low, Py_ssize_t high, bint segments) noexcept nogil

@cython.locals(segments=bint)
cdef double _direction(Newton n, double imbalance, double pivot) noexcept nogil
cdef void _factor_with_shared(Newton n, Py_ssize_t q) noexcept nogil
cdef void _border_row(
    Newton n, Py_ssize_t k, Py_ssize_t column, Py_ssize_t low, Py_ssize_t high, double[::1] result, Py_ssize_t out
) noexcept nogil
cdef void _factor_whole(Newton n) noexcept nogil

@cython.locals(stale=bint)
cdef double _shared_direction(Newton n, double imbalance) noexcept nogil

cdef double _turn(Newton n, double imbalance, double pivot) noexcept nogil
cdef double _stiffness(Newton n) noexcept nogil

@cython.locals(moment=double, pivot=double, low=Py_ssize_t, high=Py_ssize_t)
cdef (double, double) _stuck(Newton n) noexcept nogil

@cython.locals(amplitude=double, left=double, of_blocks=double, level=double)
cdef double _residual(Newton n, double torque, double moment) noexcept nogil

@cython.locals(bending=double, local=double)
cdef (double, double) _slope(Newton n, double torque, double moment, double turn) noexcept nogil

cdef (double, double, bint) _move(Newton n, double length, double rotation, bint linear) noexcept nogil
cdef void _copy(const double[::1] given, double[::1] result) noexcept nogil

@cython.locals(least=double, steps=Py_ssize_t, ended=bint, kept=double, current=Py_ssize_t, changed=bint,
               iteration=Py_ssize_t, halving=Py_ssize_t, slope=double, length=double)
cdef (double, Py_ssize_t, bint) _iterate(
    Newton n, double torque, double rotation, bint linear, bint coarse
) noexcept nogil

@cython.locals(total=Py_ssize_t)
cdef Py_ssize_t _take(
    Newton n, Py_ssize_t level, const double[::1] arm, const double[::1] local, bint linear, double guess, bint highest
) noexcept nogil

@cython.locals(winkler=double, some=bint)
cdef (double, double) _start(
    Newton n, Py_ssize_t total, double torque, const unsigned char[:, ::1] mask, Py_ssize_t b
) noexcept nogil

cdef void _forces_of_level(Newton n, Py_ssize_t level, Py_ssize_t top, double guess) noexcept nogil

@cython.locals(rotation=double, winkler=double, steps=Py_ssize_t, ended=bint, guess=double)
cdef (double, Py_ssize_t, bint) _solve(
    Newton n, double torque, const double[::1] arm, const double[::1] local, bint linear,
    const unsigned char[:, ::1] mask, Py_ssize_t b,
) noexcept nogil

@cython.locals(spread=double, compliance=double, columns=Py_ssize_t)
cdef double _answer(
    Newton n, bint linear, const double[::1] local, const double[::1] diagonal, const double[::1] factor, double rotation, const double[::1] arm, double[:, ::1] force, double[:, ::1] gap, double[:, ::1] secant, Py_ssize_t b,
) noexcept nogil

@cython.locals(
    n=Newton, linear=bint,
    known=double, b=Py_ssize_t,
)
cpdef solve_batch(
    tuple modes, const double[::1] factor, const double[::1] torque, const double[:, ::1] separation, const double[::1] arm,
    const double[::1] local, const double[::1] diagonal, const double[:, ::1] law, const unsigned char[:, ::1] mask, double[:, ::1] force,
    double[:, ::1] gap, double[:, ::1] secant, double[:, ::1] numbers, int64_t[:, ::1] counts,
)
