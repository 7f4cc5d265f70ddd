# cmake --install: the libraries (see clearway_library) with find_package(clearway), the program, its data, its pages
# of the manual and its completion. CPack makes a Debian package of all.
include(CMakePackageConfigHelpers)
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/clearway)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/clearway-config.cmake.in
  ${PROJECT_BINARY_DIR}/clearway-config.cmake INSTALL_DESTINATION ${config}
  PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/clearway-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/clearway-config.cmake ${PROJECT_BINARY_DIR}/clearway-config-version.cmake
  DESTINATION ${config})

install(DIRECTORY ${PROJECT_SOURCE_DIR}/datasets/robots ${PROJECT_SOURCE_DIR}/datasets/scenes
  ${PROJECT_SOURCE_DIR}/datasets/setups ${PROJECT_SOURCE_DIR}/datasets/suites
  DESTINATION ${CMAKE_INSTALL_DATADIR}/clearway PATTERN "*.md" EXCLUDE)

# Pages, and what they link to, lie as in the sources, so that their links lead there.
include(${CMAKE_CURRENT_LIST_DIR}/page_links.cmake)
file(GLOB documents CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/*.md)
foreach(floor apps datasets mapping planning tracking)
  file(GLOB pages CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${floor}/*.md
    ${PROJECT_SOURCE_DIR}/${floor}/*/*.md)
  list(APPEND documents ${pages})
endforeach()
foreach(page ${documents})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${page})
  page_links(${PROJECT_SOURCE_DIR}/${page} links)
  cmake_path(GET page PARENT_PATH folder)
  foreach(link ${links})
    cmake_path(APPEND folder ${link} OUTPUT_VARIABLE target)
    cmake_path(NORMAL_PATH target)
    list(APPEND documents ${target})
  endforeach()
endforeach()
list(REMOVE_DUPLICATES documents)
foreach(document LICENSE ${documents})
  cmake_path(GET document PARENT_PATH folder)
  if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/${document})
    install(DIRECTORY ${document} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} PATTERN __pycache__ EXCLUDE)
  else()
    install(FILES ${document} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
  endif()
endforeach()

if(CLEARWAY_APPS)
  install(TARGETS clearway)
  install(TARGETS clearway_full DESTINATION libexec)

  set(texts ${PROJECT_BINARY_DIR}/manual)
  install(FILES ${texts}/clearway.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${texts}/clearway DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${texts}/_clearway DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
endif()

# cmake --build … --target docs: pages of the installed headers, in the build folder's docs/html.
find_package(Doxygen 1.9 QUIET)
if(DOXYGEN_FOUND )
  get_property(headers GLOBAL PROPERTY CLEARWAY_PUBLIC_HEADERS)
  list(REMOVE_DUPLICATES headers)
  set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/docs)
  set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR})
  set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
  set(DOXYGEN_EXTRACT_ALL YES)
  set(DOXYGEN_QUIET YES)
  set(DOXYGEN_WARN_IF_INCOMPLETE_DOC NO)  # a name that says all needs no @param
  set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
  doxygen_add_docs(docs ${headers} COMMENT "Writing the API pages")
endif()

# cpack in the build folder: clearway_VERSION_amd64.deb. It depends on what the program loads; what programs that link
# the libraries need as well is only suggested.
file(STRINGS ${PROJECT_SOURCE_DIR}/.ci/packages packages REGEX "^([a-z].*-dev|pkg-config)$")
list(JOIN packages ", " packages)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the Clearway authors <clearway@example.org>")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core")  # the letters of pictures
# Loaded when a video or a window is opened, and by the Python module.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libopencv-videoio406, libopencv-highgui406, python3-numpy")
if(TARGET clearway_python)
  set(CPACK_DEBIAN_PACKAGE_PROVIDES "python3-clearway")
endif()
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "${packages}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
include(CPack)
