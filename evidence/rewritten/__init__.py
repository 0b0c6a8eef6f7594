"""One linkage written in many ways: every answer that must agree is compared."""
