"""Results as text, Markdown, JSON, CSV, and files that appear whole."""
