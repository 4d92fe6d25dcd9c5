"""What commands share in showing: tables, text, curves and pictures."""
