"""The questions, asked of any problem, and the methods that can answer them."""
