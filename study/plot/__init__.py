"""Figures of results, reached as ``easeoff.plot``, and their files.

Every function takes a result and returns a matplotlib ``Figure``, a page of its own. With ``axes`` it draws in the
caller's axes, one a panel, row by row, in the text sizes of their figure, and returns nothing, so that a notebook shows
them once. ``pictures`` lists what a result has; ``write_pictures`` writes the files.

>>> import easeoff
>>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
>>> figure = easeoff.plot.pressure(tree)
>>> figure.savefig("pressure.png")  # doctest: +SKIP
"""

from ...core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
