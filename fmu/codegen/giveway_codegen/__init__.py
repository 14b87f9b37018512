"""Turns a variable table and a robot file into C++ sources, FMI model descriptions, a page and an FMU."""
