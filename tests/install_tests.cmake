# What an installation has and does: tests/install.
file(GLOB install_tests CONFIGURE_DEPENDS install/*_test.py)
foreach(script ${install_tests})
  cmake_path(GET script STEM name)
  add_test(NAME install_${name} COMMAND ${Python3_EXECUTABLE} ${script})
  set_tests_properties(install_${name} PROPERTIES TIMEOUT 300 ENVIRONMENT
                       "ORACLEGS_BUILD=${CMAKE_BINARY_DIR};ORACLEGS_CMAKE=${CMAKE_COMMAND};PYTHONDONTWRITEBYTECODE=1")
endforeach()
