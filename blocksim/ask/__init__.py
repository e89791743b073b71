"""The questions, and the methods that can answer them."""
