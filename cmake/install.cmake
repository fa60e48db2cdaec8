# What `cmake --install` lays down: libraries, headers, program, CMake package and pkg-config files.
include(CMakePackageConfigHelpers)

set(KDRAY_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/kdray)
set(KDRAY_PKGCONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# Libraries and headers
set(installed kdray)
set(headers cost.h counts.h kdray.h plan.h rays.h tree.h)
if(KDRAY_RENDER)
  list(APPEND installed kdray-render)
  list(APPEND headers render.h)
endif()
if(KDRAY_OPENMP)
  list(APPEND installed kdray-openmp)
  list(APPEND headers openmp.h)
endif()
install(TARGETS ${installed} EXPORT kdray-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
list(TRANSFORM headers PREPEND ${PROJECT_SOURCE_DIR}/include/kdray/)
install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kdray)

# Program: it finds the libraries beside it, wherever the prefix is.
if(TARGET kdray-program)
  file(RELATIVE_PATH lib_from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
  set_target_properties(kdray-program PROPERTIES INSTALL_RPATH "$ORIGIN/${lib_from_bin}")
  install(TARGETS kdray-program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

# CMake package: find_package(kdray) gives kdray::kdray, kdray::render and kdray::openmp.
install(EXPORT kdray-targets NAMESPACE kdray:: DESTINATION ${KDRAY_CMAKE_DIR})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/kdray-config.cmake.in ${PROJECT_BINARY_DIR}/kdray-config.cmake
  INSTALL_DESTINATION ${KDRAY_CMAKE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kdray-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kdray-config.cmake ${PROJECT_BINARY_DIR}/kdray-config-version.cmake
  DESTINATION ${KDRAY_CMAKE_DIR})

# kdray_pkgconfig(NAME DESCRIPTION [REQUIRES pc...] [PRIVATE pc...] [LIBRARIES flag...]): what stands behind a library
# matters to static linking only; a shared library brings it along.
function(kdray_pkgconfig NAME DESCRIPTION)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "REQUIRES;PRIVATE;LIBRARIES")
  list(JOIN arg_REQUIRES " " REQUIRES)
  set(REQUIRES_PRIVATE)
  set(LIBRARIES_PRIVATE)
  if(NOT BUILD_SHARED_LIBS)
    list(JOIN arg_PRIVATE " " REQUIRES_PRIVATE)
    list(JOIN arg_LIBRARIES " " LIBRARIES_PRIVATE)
  endif()
  file(RELATIVE_PATH PREFIX /prefix/${KDRAY_PKGCONFIG_DIR} /prefix)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/library.pc.in ${PROJECT_BINARY_DIR}/${NAME}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${NAME}.pc DESTINATION ${KDRAY_PKGCONFIG_DIR})
endfunction()

kdray_pkgconfig(kdray "Ray queries against triangles through a kd-tree" LIBRARIES -pthread -lm)
if(KDRAY_RENDER)
  set(behind libpng zlib)
  if(TARGET PkgConfig::assimp)
    list(APPEND behind assimp)
  endif()
  kdray_pkgconfig(kdray-render "Mesh files to pictures, on top of kdray" REQUIRES kdray PRIVATE ${behind}
    LIBRARIES -pthread -lm)
endif()
if(KDRAY_OPENMP)
  kdray_pkgconfig(kdray-openmp "OpenMP threads for kdray" REQUIRES kdray LIBRARIES ${OpenMP_C_FLAGS})
endif()
