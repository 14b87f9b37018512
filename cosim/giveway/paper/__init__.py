"""The numbers that the paper prints (`printed`), and which of them our values were chosen to match (`matched`)."""
