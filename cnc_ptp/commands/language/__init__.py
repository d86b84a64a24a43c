"""The NC language for its readers: `cnc_ptp explain` and docs/nc_language.md."""
