"""What tests share: how the program is run, what it is compared with, and what is kept."""
