"""A UMAT that examines its host, and its runs in the driver, CalculiX and OpenGeoSys."""
