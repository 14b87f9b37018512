"""How results show themselves in Jupyter: `page.py` has the HTML of each class that is `ShownInNotebooks`."""
