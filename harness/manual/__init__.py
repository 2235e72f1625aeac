"""The manual: pages written by hand, pages made from the code, and the site of both."""
