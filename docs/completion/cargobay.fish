# Fish completion of the command cargobay. It asks the command itself: `cargobay complete WORD...`
# prints the words that may stand next, each with a tab and its meaning, and `:files` where names of
# files may, too.

function __cargobay_complete
    set -l tokens (commandline -opc)
    set -l current (commandline -ct)
    set -l program (string replace -r '^~/' "$HOME/" -- $tokens[1])
    for line in ($program complete $tokens[2..-1] "$current" 2>/dev/null)
        if test "$line" = :files
            # Of "--json=out", the file is what is after the "=".
            set -l joined (string match -r -- '^--[^=]*=' "$current")
            for file in (complete -C "'' "(string replace -r -- '^--[^=]*=' '' "$current"))
                echo "$joined$file"
            end
        else
            echo $line
        end
    end
end

complete -c cargobay -f -a '(__cargobay_complete)'
