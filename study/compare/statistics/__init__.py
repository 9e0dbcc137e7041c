"""Statistics of a comparison: methods in order, profiles, growth with size, work against precision."""
