"""How many weights of finite size, and how large: Goncharov 2017."""
