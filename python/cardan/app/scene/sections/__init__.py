"""The sections of a scene, one in each file: keys, rules, and what is made of them."""
