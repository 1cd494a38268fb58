#!/bin/sh
# Installs our packages, as of an older version.
set -eu
folder=$(mktemp -d)
for package in /share/*.deb; do
  name=$(basename "$package" .deb)
  dpkg-deb -R "$package" "$folder/$name"
  version=$(sed -n 's/^Version: //p' "$folder/$name/DEBIAN/control")
  sed -i "s/$version/0.0.9-1/g" "$folder/$name/DEBIAN/control"
  dpkg-deb -Znone -b "$folder/$name" "$folder/$name.deb" > /dev/null
done
dpkg -i "$folder"/*.deb
rm -r "$folder"
