cimport cython
from libc.math cimport sqrt


@cython.locals(s="double[16]", k=Py_ssize_t, x=Py_ssize_t, lane=Py_ssize_t)
cdef void row_products(
    const double[::1] matrix, Py_ssize_t at, Py_ssize_t stride, Py_ssize_t rows, const double[::1] vector,
    Py_ssize_t first, Py_ssize_t length, double[::1] result, Py_ssize_t out,
) noexcept nogil

@cython.locals(s="double[4]")
cdef double dot(
    const double[::1] one, Py_ssize_t first, const double[::1] other, Py_ssize_t second, Py_ssize_t length
) noexcept nogil

cdef void add_rows(
    const double[::1] matrix, Py_ssize_t at, Py_ssize_t stride, Py_ssize_t rows, const double[::1] factor,
    Py_ssize_t first, double[::1] result, Py_ssize_t out, Py_ssize_t length,
) noexcept nogil

@cython.locals(s="double[16]")
cdef void products(
    const double[::1] one, Py_ssize_t first, Py_ssize_t stride, Py_ssize_t rows, const double[::1] other,
    Py_ssize_t second, Py_ssize_t other_stride, Py_ssize_t others, Py_ssize_t length, bint lower, double[::1] result,
    Py_ssize_t out, Py_ssize_t width,
) noexcept nogil

cdef void gram(
    const double[::1] rows, Py_ssize_t at, Py_ssize_t stride, Py_ssize_t count, Py_ssize_t length,
    double[::1] result, Py_ssize_t out, Py_ssize_t width, Py_ssize_t ones,
) noexcept nogil

@cython.locals(s="double[16]")
cdef void eliminate(
    double[::1] matrix, Py_ssize_t at, Py_ssize_t stride, Py_ssize_t begin, Py_ssize_t end, Py_ssize_t size
) noexcept nogil

@cython.locals(s="double[4]")
cdef void forward(
    const double[::1] factor, Py_ssize_t at, Py_ssize_t stride, Py_ssize_t size, double[::1] right, Py_ssize_t first
) noexcept nogil

@cython.locals(s="double[4]")
cdef void backward(
    const double[::1] factor, Py_ssize_t at, Py_ssize_t stride, Py_ssize_t size, double[::1] right, Py_ssize_t first
) noexcept nogil
