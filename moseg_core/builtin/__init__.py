"""The core's own components: one module each, offered as the bundle ``core`` by ``plugin``."""
