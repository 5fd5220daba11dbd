# Debian packages and a tarball of what is installed: `cpack -G DEB` and `cpack -G TGZ` in the build folder, or
# packaging/build.sh. Debian's tools find the packages that shared libraries need.
set(ORACLEGS_MAINTAINER "OracleGS contributors <oraclegs@noreply.example>" CACHE STRING "Maintainer named in packages")
set(CPACK_PACKAGE_NAME oraclegs)
set(CPACK_PACKAGE_VENDOR "OracleGS")
set(CPACK_PACKAGE_CONTACT "${ORACLEGS_MAINTAINER}")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/packaging/tarball.cmake)
set(CPACK_COMPONENTS_ALL runtime dev)
if(ORACLEGS_NETWORKS)
  list(INSERT CPACK_COMPONENTS_ALL 1 networks)
endif()
if(ORACLEGS_CUDA)
  list(INSERT CPACK_COMPONENTS_ALL 1 cuda)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Depends on COLMAP, because photos without poses are what the program is for. ffmpeg, which brings as much as everything else
# together, only makes and reads videos; the program names it when it is missing.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME oraclegs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "colmap")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "oraclegs-networks, oraclegs-cuda, ffmpeg")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "3D Gaussian splats from a few photos
OracleGS reconstructs scenes from 3 to 24 photos, on a laptop without a GPU:
it finds the cameras, estimates depth, proposes views that no photo shows,
decides for each pixel of a proposal how far to trust it, and trains
3D Gaussians. A report, a viewer, meshes and the formats of other viewers
are part of it.

Start with: oraclegs demo")

set(CPACK_DEBIAN_NETWORKS_PACKAGE_NAME oraclegs-networks)
set(CPACK_DEBIAN_NETWORKS_PACKAGE_DEPENDS "oraclegs (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_NETWORKS_PACKAGE_RECOMMENDS "libopenblas0-pthread")  # the reference BLAS is four times slower
set(CPACK_COMPONENT_NETWORKS_DESCRIPTION "Networks of OracleGS, which need libtorch
Depth Anything V2, LPIPS, VGGT and Stable Virtual Camera for oraclegs. Their
weights are not part of the package: oraclegs models fetches them. Everything
else works without this package.")

set(CPACK_DEBIAN_CUDA_PACKAGE_NAME oraclegs-cuda)
set(CPACK_DEBIAN_CUDA_PACKAGE_DEPENDS "oraclegs (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_CUDA_DESCRIPTION "NVIDIA GPUs for OracleGS
The engine of oraclegs for NVIDIA GPUs from Turing on. It needs NVIDIA's driver
and nothing else of CUDA; oraclegs uses the GPU as soon as both are there.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME oraclegs-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "oraclegs (= ${PROJECT_VERSION}), libeigen3-dev, libfmt-dev, libspdlog-dev, \
nlohmann-json3-dev, libpng-dev, zlib1g-dev, libturbojpeg0-dev, libhwy-dev, pkg-config")
foreach(library heif tiff webp)
  if("${library}=${${library}_MODULE_NAME}" IN_LIST modules)
    string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", lib${library}-dev")
  endif()
endforeach()
set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers and static libraries of OracleGS
Rasterizer, training and depth of oraclegs for other programs, as the CMake
package oraclegs. The interface changes with every minor version.")

# The files that Debian wants of every package.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(${CMAKE_SOURCE_DIR}/packaging/changelog.in ${CMAKE_BINARY_DIR}/packages/changelog @ONLY)
execute_process(COMMAND gzip -9nf changelog WORKING_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER ${component} key)
  install(FILES ${CMAKE_SOURCE_DIR}/packaging/copyright ${CMAKE_BINARY_DIR}/packages/changelog.gz COMPONENT ${component}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${key}_PACKAGE_NAME})
endforeach()
include(CPack)
