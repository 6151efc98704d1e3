# The Debian package, by `cpack -G DEB` in a build with -DCMAKE_INSTALL_PREFIX=/usr (./dev package).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME seldinger)
# the project's address has one place
file(STRINGS pyproject.toml address REGEX "^Repository = ")
string(REGEX REPLACE ".*https?://([^/\"]+).*" "\\1" address "${address}")
set(CPACK_PACKAGE_CONTACT "The Seldinger developers <developers@${address}>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulation of guidewires and catheters in blood vessels")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Seldinger simulates guidewires, catheters and sheaths as they are
pushed, pulled and turned inside blood vessels. It runs in real time and
estimates the error of its forces and tip position.
.
The package has the command, its scenes and instruments, the C++
library with its headers, and the documents as pages.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# libraries that are linked: by dpkg-shlibdeps. The vendor of OpenCL and the font are found at run time
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "pocl-opencl-icd | opencl-icd, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libegl1, libopengl0, libgl1-mesa-dri, python3-matplotlib, libjs-three, ffmpeg")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake")
file(WRITE ${CMAKE_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
# CPack's own names the library once for each variant
file(WRITE ${CMAKE_BINARY_DIR}/debian/shlibs "libseldinger ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} seldinger\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/debian/triggers ${CMAKE_BINARY_DIR}/debian/shlibs)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/installed)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where it is set
file(WRITE ${CMAKE_BINARY_DIR}/debian/changelog
  "seldinger (${PROJECT_VERSION}) unstable; urgency=medium\n\n  * See CHANGELOG.md of the source.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
execute_process(COMMAND gzip -9nf ${CMAKE_BINARY_DIR}/debian/changelog COMMAND_ERROR_IS_FATAL ANY)
install(FILES packaging/copyright ${CMAKE_BINARY_DIR}/debian/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/seldinger)
include(CPack)
