#!/bin/sh
# Installs what building and running wisplab needs, from Debian's packages; quick when nothing is
# missing.  --ci adds what .ci/run needs besides.
set -eu

# The compiler and the build, with git for the commit that results name; the libraries (README says
# what each is for); the tests; the figures, and a font for their texts.
packages="build-essential cmake ninja-build pkg-config git
          libsundials-dev libsuitesparse-dev libgsl-dev libconfig-dev libjansson-dev
          libcairo2-dev libwebp-dev libcriterion-dev gnuplot-nox fonts-dejavu-core"
case ${1-} in
'') ;;
--ci) packages="$packages clang libclang-rt-dev clang-format valgrind
                         python3-pandas python3-scipy python3-vtk9 librsvg2-bin" ;;
*) echo "usage: $0 [--ci]" >&2 && exit 1 ;;
esac

cannot() {
    echo "bootstrap.sh: $1; it would install:" $missing >&2
    exit 1
}

# What dpkg does not list as installed.
installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $packages 2>/dev/null) || true
missing=
for package in $packages; do
    case "
$installed
" in
    *"
installed $package
"*) ;;
    *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

command -v apt-get >/dev/null || cannot "this system has no apt-get"
as_root=
if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || cannot "neither root nor sudo"
    as_root=sudo
    [ -t 0 ] || as_root="sudo -n" # nobody to type a password
    $as_root true 2>/dev/null || cannot "sudo refused"
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o Dpkg::Use-Pty=0 \
        -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" </dev/null >>"$log" 2>&1
}

echo "bootstrap.sh: installing" $missing
# The package lists may be absent or old: then a first try fails early, and is made again.
if ! apt install --no-install-recommends $missing; then
    echo "bootstrap.sh: fetching the package lists first"
    : >"$log"
    if ! apt update || ! apt install --no-install-recommends $missing; then
        tail -n 10 "$log" >&2
        cannot "apt-get failed"
    fi
fi
