"""Plan panel: what is modelled and what is left out."""
