"""Hosts of MFront's generic interface (MGIS): a scene's UMAT as a behaviour, and its trial in OpenGeoSys."""
