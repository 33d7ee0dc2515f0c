"""Pictures of segmentations and of searches, made without a screen, a GPU or a graphics library."""
