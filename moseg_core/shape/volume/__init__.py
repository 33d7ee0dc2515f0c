"""The volume V of Sec. 10: exact where a mesh encloses one, estimated when the user asks."""
