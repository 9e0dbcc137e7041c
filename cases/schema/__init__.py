"""The schemas of case and design files, table by table."""
