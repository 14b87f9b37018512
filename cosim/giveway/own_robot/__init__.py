"""Robot files that help: `giveway robot new` writes one, `check` says what is wrong with it or assumed."""
