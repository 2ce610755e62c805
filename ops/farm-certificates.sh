#!/bin/sh
# Certificates for one farm: an authority of its own, one certificate for the coordinator, which
# names the hosts under which it is reached, and one for workers and users.
#
# usage: ops/farm-certificates.sh FOLDER HOST... (names or IPv4 addresses)
#
# FOLDER must not exist. Valid for IRSIG_CERTIFICATE_DAYS (365) days. Whoever has a certificate of
# this authority may do everything at the coordinator: docs/security.md.
set -eu
[ $# -ge 2 ] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
folder=$1
shift
days=${IRSIG_CERTIFICATE_DAYS:-365}
umask 077
mkdir "$folder"

hosts=
for host in "$@"; do
  case $host in
    *[!0-9.]*) kind=DNS ;;
    *) kind=IP ;;
  esac
  hosts="$hosts${hosts:+,}$kind:$host"
done

# All that openssl says is of interest only when it fails.
quietly() { openssl "$@" > "$folder/log" 2>&1 < /dev/null || { cat "$folder/log" >&2; exit 1; }; }
key="-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes"
quietly req -x509 $key -days "$days" -subj "/CN=irsig farm authority" \
  -keyout "$folder/ca.key" -out "$folder/ca.pem"
sign() {  # NAME EXTENSION
  quietly req $key -subj "/CN=irsig $1" -keyout "$folder/$1.key" -out "$folder/request"
  printf '%s\n' "$2" > "$folder/extension"
  quietly x509 -req -in "$folder/request" -CA "$folder/ca.pem" -CAkey "$folder/ca.key" \
    -CAcreateserial -days "$days" -extfile "$folder/extension" -out "$folder/$1.pem"
}
sign coordinator "subjectAltName=$hosts"
sign client "extendedKeyUsage=clientAuth"
rm -f "$folder/request" "$folder/extension" "$folder/log" "$folder/ca.srl"
