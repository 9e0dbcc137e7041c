"""The contact problem: data, scaling, certificate, equivalent forms, files; no gear in here."""
