"""Results and sweeps in a notebook: the accessors ``easeoff`` of trees and datasets of xarray."""
