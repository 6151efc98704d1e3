# Turns the plain comments of a header into Doxygen's, line by line: those at its top say what the file is for, those at the end
# of a declaration what it means.
1s|^#pragma once|/// @file|
1,/^$/s|^//|///|
s|\([;,{]\)  *// |\1  ///< |
