"""Many linkages: dimensions over grids and samples, measures of each, tables that survive a crash."""
