"""Pictures of segmentations, made without a screen, a GPU or a graphics library."""
