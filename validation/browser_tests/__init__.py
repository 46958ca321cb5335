"""The pages of the harness in a browser: what a reader can do with them, and what they must not do."""
