"""Files for other programs: measuring points, surfaces and meshes of teeth, and contact in mesh position."""
