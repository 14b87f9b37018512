// Cargo wants a target to resolve dependencies for; nothing is ever compiled.
