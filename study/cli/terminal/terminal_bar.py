"""Progress bar on a terminal."""

from __future__ import annotations

from typing import Any


def terminal_bar(**options: Any) -> Any:
    """A bar of tqdm that is shown on a terminal alone, and without tqdm's thread.

    In that thread Python may collect garbage, and close a netCDF file while the main thread is in the netCDF library,
    which ends the process.

    Parameters
    ----------
    **options
        Arguments of ``tqdm.tqdm``.

    Examples
    --------
    >>> with terminal_bar(total=2) as bar:
    ...     bar.update(1) is None or True
    True
    """
    from tqdm import tqdm

    tqdm.monitor_interval = 0
    return tqdm(disable=None, leave=False, **options)
