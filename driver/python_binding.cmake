# The extension module plyflow._driver_library: f90wrap writes Fortran wrappers and plyflow/driver_library,
# f2py writes their C face, and both are compiled here with NumPy's array bridge.
enable_language(C)
find_package(Python REQUIRED COMPONENTS Interpreter Development.Module NumPy)
execute_process(
  COMMAND ${Python_EXECUTABLE} -c "import numpy.f2py; print(numpy.f2py.get_include())"
  OUTPUT_VARIABLE F2PY_INCLUDE_DIR OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

set(BINDING_DIR ${CMAKE_CURRENT_BINARY_DIR}/binding)
set(BINDING_SOURCE ${PROJECT_SOURCE_DIR}/driver/driver_binding.f90 ${PROJECT_SOURCE_DIR}/driver/driver_batch.f90)
set(BINDING_WRAPPERS ${BINDING_DIR}/f90wrap_driver_binding.f90 ${BINDING_DIR}/f90wrap_driver_batch.f90)
set(BINDING_KINDS ${PROJECT_SOURCE_DIR}/driver/f90wrap_kinds.txt)
file(MAKE_DIRECTORY ${BINDING_DIR})

add_custom_command(
  OUTPUT ${BINDING_WRAPPERS} ${BINDING_DIR}/driver_library/driver_binding.py
         ${BINDING_DIR}/driver_library/driver_batch.py
  COMMAND ${Python_EXECUTABLE} -m f90wrap --move-methods --package --relative -m driver_library -k ${BINDING_KINDS}
          ${BINDING_SOURCE}
  WORKING_DIRECTORY ${BINDING_DIR}
  DEPENDS ${BINDING_SOURCE} ${BINDING_KINDS}
  COMMENT "f90wrap: Fortran wrappers and Python module"
  VERBATIM)
add_custom_command(
  OUTPUT ${BINDING_DIR}/_driver_librarymodule.c
  COMMAND ${Python_EXECUTABLE} -m f90wrap.scripts.f2py_f90wrap -m _driver_library --build-dir ${BINDING_DIR}
          --f2cmap ${BINDING_KINDS} ${BINDING_WRAPPERS}
  WORKING_DIRECTORY ${BINDING_DIR}
  DEPENDS ${BINDING_WRAPPERS}
  COMMENT "f2py: C face of the wrappers"
  VERBATIM)

add_library(plyflow_driver_binding OBJECT driver/driver_binding.f90 driver/driver_batch.f90)
set_target_properties(plyflow_driver_binding PROPERTIES
  POSITION_INDEPENDENT_CODE ON
  Fortran_MODULE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/modules)
target_include_directories(plyflow_driver_binding PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/modules)
target_link_libraries(plyflow_driver_binding PRIVATE plyflow_driver_modules plyflow_driver_flags)

python_add_library(_driver_library MODULE WITH_SOABI
  ${BINDING_DIR}/_driver_librarymodule.c
  ${BINDING_WRAPPERS}
  ${F2PY_INCLUDE_DIR}/fortranobject.c)
target_include_directories(_driver_library PRIVATE
  ${F2PY_INCLUDE_DIR} ${CMAKE_CURRENT_BINARY_DIR}/modules)
target_link_libraries(_driver_library PRIVATE
  plyflow_driver_binding plyflow_driver_modules Python::NumPy ${CMAKE_DL_LIBS})
if(OpenMP_Fortran_FOUND)
  target_link_libraries(plyflow_driver_binding PRIVATE OpenMP::OpenMP_Fortran)
  target_link_libraries(_driver_library PRIVATE OpenMP::OpenMP_Fortran)
endif()

install(TARGETS _driver_library LIBRARY DESTINATION plyflow)
install(DIRECTORY ${BINDING_DIR}/driver_library DESTINATION plyflow FILES_MATCHING PATTERN "*.py")
install(DIRECTORY umat/ DESTINATION plyflow/data/umat OPTIONAL)
