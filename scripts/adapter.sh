#!/bin/sh
# Asks the GPU of this machine what docs/adapters.md shows, in eight minutes at most, and says which
# folder to hand in. Needs a Vulkan, Metal or GL driver, and nothing else: no compiler, no network,
# no root.
#
#     ./adapter.sh                         the best GPU
#     ./adapter.sh --backend gl            through another interface: vulkan, metal, dx12, gl
#     ./adapter.sh --adapter RADV          by part of its name or of its driver's
#     ./adapter.sh --memory-limit 2GiB     most memory for the textures and buffers of a method
#     ./adapter.sh --small                 a short try: small rows, which measure little
#     ./adapter.sh --only hard,park        these rows alone
#     ./adapter.sh --again                 rows that the folder holds already, too
#     ./adapter.sh --minutes 20            for all rows, instead of 8
#     ./adapter.sh --out DIR               folder for the rows, else named by adapter and driver
#     ./adapter.sh --program PATH          another program than the one beside this script
#
# Each row is a command of the program in a process of its own, with a time limit: a crash, a lost
# device and a hang are answers, too. Stopped, or out of time, it goes on with the same command.
# Exit codes: 0 fine, 1 the folder cannot be taken, 2 wrong usage, 3 no usable GPU, 130 Ctrl-C.
set -eu

# The questions. A row has a name, the most seconds (generous, as a machine may have other work), an
# ability of the adapter and a backend (without the one and on the other it is left out, as its
# methods do not run or are not proven there; `-` for none), the question, the words of the command,
# and those of the small row, which may be missing.
rows() {
    row hard 150 - - 'is every method right on the hard cases, as guaranteed?' \
        'stress rt light_buffer crsm crsma_full nsm --size 128x128 --map-size 128' \
        'stress rt light_buffer --size 32x32 --map-size 32 --case grid_of_holes --case torus'
    row hard_area 60 - gl 'the same under lights with an extent' \
        'stress rt_area light_buffer_area --size 64x64 --map-size 64 --set samples=4' \
        'stress rt_area light_buffer_area --size 24x24 --map-size 24 --set samples=4 --case torus'
    row hard_ray_query 90 ray_query - "the same by the driver's ray queries" \
        'stress rt rt_area --size 64x64 --map-size 64 --set engine=ray_query --set samples=4' \
        'stress rt --size 32x32 --map-size 32 --set engine=ray_query --case torus'
    row park 90 - - 'are two ways to hard shadows the same bits, in nine views of closed meshes?' \
        'compare rt light_buffer crsm crsma_full nsm --scene park --view all --size 256x256 --map-size 512 --data npy --frames 3' \
        'compare rt light_buffer nsm --scene park --size 48x48 --map-size 64 --data npy --frames 1'
    row lamps 60 - - 'the same under a spot, a point and a directional light' \
        'compare rt light_buffer nsm --scene lamps --view all --light all --size 256x256 --map-size 512 --data npy --frames 3' \
        'compare rt light_buffer --scene lamps --light all --size 32x32 --data npy --frames 1'
    row area 150 - gl 'do lists and rays give the same shares of an extended light, to the bit?' \
        'compare rt_area light_buffer_area --scene park_soft --size 128x128,256x256 --reference-samples 64 --data npy --frames 3' \
        'compare rt_area light_buffer_area --scene park_soft --size 32x32 --reference-samples 16 --set samples=4 --data npy --frames 1'
    row sizes 240 - - 'what does a frame cost by its size?' \
        'compare rt light_buffer nsm crsm --scene sponza --size 256x256,512x512,1024x1024,1920x1080 --map-size 1024 --frames 5' \
        'compare rt light_buffer nsm --scene park --size 40x40,64x64 --map-size 64 --frames 2'
    row sizes_ray_query 90 ray_query - 'the same by ray queries' \
        'compare rt rt@engine=ray_query --scene sponza --size 256x256,1024x1024 --frames 5' \
        'compare rt rt@engine=ray_query --scene park --size 40x40 --frames 1'
    row city_10000 60 - - 'what does a frame cost by the number of triangles?' \
        'compare rt light_buffer nsm crsm --scene city:10000 --view overview --size 1024x576 --map-size 1024 --frames 5' \
        'compare rt light_buffer nsm --scene city:10000 --view overview --size 48x27 --map-size 64 --frames 1'
    row city_100000 60 - - 'the same, ten times as many' \
        'compare rt light_buffer nsm crsm --scene city:100000 --view overview --size 1024x576 --map-size 1024 --frames 5'
    row city_1000000 120 - - 'the same, a hundred times as many' \
        'compare rt light_buffer nsm crsm --scene city:1000000 --view overview --size 1024x576 --map-size 1024 --frames 5'
}

# Words behind each comparison: no pictures, only the time of whole frames, and what a killed process
# has measured is kept.
compared='--warmup 1 --regime-frames 0 --images none --resume'
# Seconds after which a frame is given up: sooner than a row's process, so that the row tells which
# pass hung.
frame_seconds=25
lacking='not on this adapter'

say() { printf '%s\n' "$*" >&2; }
# Ends with an exit code and a message.
end() {
    code=$1
    shift
    say "error: $*"
    exit "$code"
}

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
adapter='' backend='' memory='' small='' only='' again='' minutes=8 folder='' program=''
while [ $# -gt 0 ]; do
    case $1 in
        --*=*)
            word=$1
            shift
            set -- "${word%%=*}" "${word#*=}" "$@"
            ;;
    esac
    case $1 in
        --small) small=yes && shift && continue ;;
        --again) again=yes && shift && continue ;;
        --help | -h) sed -n '2,/^set/s/^# \{0,1\}//p' "$0" && exit 0 ;;
        --adapter | --backend | --memory-limit | --only | --minutes | --out | --program) ;;
        *) end 2 "unknown word $1; --help says which there are" ;;
    esac
    [ $# -ge 2 ] || end 2 "$1 needs a value"
    case $1 in
        --adapter) adapter=$2 ;;
        --backend) backend=$2 ;;
        --memory-limit) memory=$2 ;;
        --only) only=$2 ;;
        --minutes) minutes=$2 ;;
        # Meant from where this script was called.
        --out) case $2 in /*) folder=$2 ;; *) folder=$PWD/$2 ;; esac ;;
        --program) case $2 in /*) program=$2 ;; *) program=$PWD/$2 ;; esac ;;
    esac
    shift 2
done
case $minutes in 0* | '' | *[!0-9]* | ?????*) minutes=0 ;; esac
[ "$minutes" -ge 1 ] && [ "$minutes" -le 1440 ] || end 2 "--minutes is a number from 1 to 1440"

# In the folder of scripts/bundle.sh, program and scenes lie beside this script, and rows are written
# there; a checkout has them in its root.
if [ -x "$here/skiagraph" ]; then
    root=$here rows_in=$here
    SKIAGRAPH_ASSETS=$here/scenes
    export SKIAGRAPH_ASSETS
    program=${program:-$here/skiagraph}
else
    root=$(cd "$here/.." && pwd)
    rows_in=$root/out
    program=${program:-$root/target/release/skiagraph}
fi
[ -x "$program" ] || end 1 "there is no program $program: unpack the whole folder, build it, or name one by --program"
# A machine that cannot start it at all is told here, and not in the rows.
built_for=$(cat "$here/built_for.txt" 2>/dev/null || echo 'another machine')
version=$("$program" --version) || end 1 "$program does not start here: it was built for $built_for"
cd "$root"

# Takes a row of the table, and hands it to $each.
row() {
    name=$1 seconds=$2 ability=$3 unproven_on=$4 question=$5 words=$6
    [ -z "$small" ] || words=${7:-}
    [ -n "$words" ] || return 0
    case $words in compare*) words="$words $compared" ;; esac
    number=$((number + 1))
    "$each"
}
is_asked_for() {
    case ,$only, in ,, | *,"$name",*) return 0 ;; esac
    return 1
}
count() {
    known="$known $name"
    ! is_asked_for || total=$((total + 1))
}
each=count number=0 total=0 known=''
rows
for name in $(printf '%s' "$only" | sed 's/,/ /g'); do
    case " $known " in *" $name "*) ;; *) end 2 "unknown row $name; there are:$known" ;; esac
done

# Runs the program with more words on the chosen adapter, until it ends or $1 seconds are over; its
# output goes into files of the folder $2. Sets `outcome`, `status` and `took`, in seconds.
limited() {
    most=$1 place=$2 start=$(date +%s) took=0 by_sigkill=crashed status=0
    shift 2
    "$program" "$@" ${adapter:+--adapter "$adapter"} ${backend:+--backend "$backend"} \
        ${memory:+--memory-limit "$memory"} </dev/null >"$place/stdout.txt" 2>"$place/stderr.txt" &
    child=$!
    [ -z "$lock" ] || printf '%s\n' $$ "$child" >"$lock"
    while [ "$took" -lt "$most" ] && kill -0 "$child" 2>/dev/null; do
        sleep 1 || true
        took=$(($(date +%s) - start))
    done
    ! kill -KILL "$child" 2>/dev/null || by_sigkill='timed out'
    wait "$child" 2>/dev/null || status=$?
    child=''
    case $status in
        0) outcome=done ;;
        3) outcome='device lost' ;;
        # A panic of Rust.
        101) outcome=crashed ;;
        # SIGHUP, SIGINT (also as the program's own exit code) and SIGTERM: the user, or what started
        # this script, ended it, which says nothing about the adapter.
        129 | 130 | 143) outcome=stopped ;;
        # Of the kernel, for want of memory, where it is not of this script.
        137) outcome=$by_sigkill ;;
        *) if [ "$status" -ge 128 ]; then outcome=crashed; else outcome=failed; fi ;;
    esac
}

# Files name no host: JSON is written without, and a row's page and CSV, which `skiagraph merge`
# makes of the JSON, are removed.
without_host() {
    rm -f "$folder"/*/report.html "$folder"/*/results.csv
    for file in "$folder"/doctor.json "$folder"/*/results.json; do
        [ -f "$file" ] || continue
        sed 's/"host": ".*"/"host": null/' "$file" >"$file.new" && mv "$file.new" "$file"
    done
}

child='' lock=''
scratch=${TMPDIR:-/tmp}/skiagraph-adapter.$$
clean() {
    trap '' HUP INT TERM
    rm -rf "$scratch"
    [ -n "$lock" ] || return 0
    without_host || true
    rm -f "$lock"
}
stop() {
    if [ -n "$child" ] && kill "$child" 2>/dev/null; then wait "$child" 2>/dev/null || true; fi
    exit "$1"
}
trap clean EXIT
trap 'stop 129' HUP
trap 'stop 130' INT
trap 'stop 143' TERM

SKIAGRAPH_PROGRESS=lines NO_COLOR=1
export SKIAGRAPH_PROGRESS NO_COLOR
began=$(date +%s)

# In a process of its own, too: a driver that crashes when it is opened is told.
mkdir "$scratch"
limited 60 "$scratch" doctor --format json
case $outcome in
    done) ;;
    stopped) exit 130 ;;
    failed | 'device lost') cat "$scratch/stderr.txt" >&2 && exit "$status" ;;
    *) end 3 "the adapter cannot be asked: skiagraph doctor $outcome (exit $status)
$(cat "$scratch/stderr.txt")" ;;
esac
of_adapter() {
    sed -n '/^  "adapter": {/,/^  }/s/^    "'"$1"'": "\(.*\)",\{0,1\}$/\1/p' "$scratch/stdout.txt"
}
has() { grep -q "^    \"$1\": true" "$scratch/stdout.txt"; }
gpu="$(of_adapter name) · $(of_adapter backend) · $(of_adapter driver)"
gpu_backend=$(of_adapter backend)
say "adapter: $gpu"

# Two drivers of one GPU have two folders. A folder goes on with rows of its own kind alone.
folder=${folder:-$rows_in/adapter-$(printf '%s' "$gpu" | sed 's/[^A-Za-z0-9_.][^A-Za-z0-9_.]*/-/g; s/^-//; s/-$//')}
mkdir -p "$folder"
kind="adapter: $gpu
program: $version, $(cksum <"$program")
rows: $([ -n "$small" ] && echo small || echo full)"
if [ ! -f "$folder/survey.txt" ]; then
    for file in "$folder"/*; do
        [ ! -e "$file" ] || end 1 "$folder holds other files; give another --out"
    done
    printf '%s\n' "$kind" >"$folder/survey.txt"
elif [ "$kind" != "$(cat "$folder/survey.txt")" ]; then
    end 1 "$folder holds rows of another kind; give another --out
it has
$(sed 's/^/  /' "$folder/survey.txt")
asked for is
$(printf '%s\n' "$kind" | sed 's/^/  /')"
fi

# The lock names the processes that work here: this one and that of its row, which survives where this
# one is killed. A lock of which none lives is left over.
file=$folder/adapter.lock
if ! (set -C && echo $$ >"$file") 2>/dev/null; then
    for process in $(cat "$file"); do
        [ "$process" = $$ ] || ! kill -0 "$process" 2>/dev/null ||
            end 1 "process $process is at work in $folder: wait for its end, or give another --out (if it is something else, remove $file)"
    done
    echo $$ >"$file"
fi
lock=$file
cp "$scratch/stdout.txt" "$folder/doctor.json"

# Runs a row that the folder does not hold yet, and records how it ended.
ask() {
    is_asked_for || return 0
    index=$((index + 1))
    own=$folder/$name
    line="skiagraph $words$chosen"
    if [ -z "$again" ] && [ -f "$own/row.txt" ] && grep -qxF "command: $line" "$own/row.txt"; then
        say "$index/$total $name: kept from before"
        return 0
    fi
    limit=$((60 * minutes + began - $(date +%s)))
    [ "$limit" -le "$seconds" ] || limit=$seconds
    outcome='' status='' took=0
    if [ "$unproven_on" = "$gpu_backend" ] || { [ "$ability" != - ] && ! has "$ability"; }; then
        outcome=$lacking
    elif [ "$limit" -lt 3 ]; then
        left="$left $name"
        return 0
    fi
    say "$index/$total $name: $question"
    # What a killed process has measured stays.
    [ ! -f "$own/row.txt" ] || rm -r "$own"
    mkdir -p "$own"
    # shellcheck disable=SC2086 # the words of a command are meant to be split
    [ -n "$outcome" ] || limited "$limit" "$own" $words --out "$own" --timeout "$frame_seconds"
    cut=''
    [ "$outcome" != stopped ] || cut='ended from outside'
    [ "$outcome" != 'timed out' ] || [ "$limit" -eq "$seconds" ] || cut="out of all rows' time"
    if [ -n "$cut" ]; then
        say "      $cut after $took s: run it again to go on"
        left="$left $name"
        return 0
    fi
    cat >"$own/row.new" <<END
number: $number
command: $line
outcome: $outcome
exit: $status
seconds: $took
limit: $seconds
date: $(date -u +%Y-%m-%d)
END
    mv "$own/row.new" "$own/row.txt"
    case $outcome in
        "$lacking") say "      $lacking" ;;
        done) say "      done after $took s" ;;
        *) say "      $outcome after $took s (exit $status): $(sed -n '/./h; ${x;p;}' "$own/stderr.txt")" ;;
    esac
}
chosen=${adapter:+" --adapter '$adapter'"}${backend:+" --backend $backend"}${memory:+" --memory-limit $memory"}
each=ask number=0 index=0 left=''
rows
[ -z "$left" ] || echo "not finished:$left; run the same command again"
echo "the folder to hand in: $folder"
