"""What happens when modules are imported: the fence of a checkout, and calls after the import of a package."""
