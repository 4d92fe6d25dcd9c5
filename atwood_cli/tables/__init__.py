"""Tables as people keep them, read: headings and cells of text."""
