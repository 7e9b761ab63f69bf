"""Images of a turning body: what cameras see of it, and the features that are followed in them."""
