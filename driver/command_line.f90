module command_line
  !! The arguments of the program.
  !!
  !!     bezel DECK [name=value ...] [--out DIR] [--check] [--restart] [--help] [--version]
  use messages, only: string, message_log, name_hint, lower_case, quoted
  use expressions, only: is_name
  use parameters, only: setting, command_line_place
  implicit none (type, external)
  private
  public :: command_options, read_command_line, parse_arguments, usage_text, default_folder

  type :: command_options
    character(:), allocatable :: deck            !! path
    character(:), allocatable :: folder          !! of the results
    type(setting), allocatable :: settings(:)    !! name=value, in the order given
    logical :: check = .false.
    logical :: restart = .false.
    logical :: help = .false.                    !! then nothing else counts
    logical :: version = .false.                 !! then nothing else counts
  end type command_options

  character(9), parameter :: option_names(5) = [character(9) :: '--out', '--check', '--restart', &
    '--help', &
    '--version']

contains

  subroutine read_command_line(options, log)
    type(command_options), intent(out) :: options
    type(message_log), intent(inout) :: log
    type(string), allocatable :: arguments(:)
    integer :: i, n

    allocate (arguments(command_argument_count()))
    do i = 1, size(arguments)
      call get_command_argument(i, length=n)
      allocate (character(n) :: arguments(i)%s)
      if (n > 0) call get_command_argument(i, arguments(i)%s)
    end do
    call parse_arguments(arguments, options, log)
  end subroutine read_command_line

  subroutine parse_arguments(arguments, options, log)
    type(string), intent(in) :: arguments(:)
    type(command_options), intent(out) :: options
    type(message_log), intent(inout) :: log
    character(*), parameter :: usage = &
      'Usage: bezel DECK [name=value ...] [--out DIR] [--check] [--restart] [--help] [--version]'
    character(:), allocatable :: item
    integer :: i, k, equals

    allocate (options%settings(0))
    options%deck = ''
    options%folder = ''
    do i = 1, size(arguments)
      options%help = options%help .or. arguments(i)%s == '--help' .or. arguments(i)%s == '-h'
      options%version = options%version .or. arguments(i)%s == '--version'
    end do
    if (options%help .or. options%version) return

    i = 0
    do while (i < size(arguments))
      i = i + 1
      item = arguments(i)%s
      equals = index(item, '=')
      if (item == '--check') then
        options%check = .true.
      else if (item == '--restart') then
        options%restart = .true.
      else if (item == '--out') then
        i = i + 1
        if (i > size(arguments)) then
          call log%add_error(command_line_place(), '', '--out needs the name of a folder', usage)
        else
          call set_folder(arguments(i)%s)
        end if
      else if (index(item, '--out=') == 1) then
        call set_folder(item(7:))
      else if (item(1:min(1, len(item))) == '-' .and. len(item) > 1) then
        call log%add_error(command_line_place(), '', 'there is no option ' // quoted(item), &
          name_hint(item, option_names, 'options'))
      else if (equals > 0) then
        if (is_name(item(1:equals-1))) then
          call add_setting(item(1:equals-1), item(equals+1:))
        else if (len(options%deck) == 0) then
          options%deck = item
        else
          call log%add_error(command_line_place(), '', quoted(item) // &
            ' does not set a parameter', &
            'It is set by name=value without blanks around the =.')
        end if
      else if (len(options%deck) == 0 .and. len(item) > 0) then
        options%deck = item
      else
        call log%add_error(command_line_place(), '', quoted(item) // &
          ' is unexpected, the deck is ' // &
          quoted(options%deck), usage)
      end if
    end do
    if (len(options%deck) == 0) call log%add_error(command_line_place(), '', &
      'the deck is missing', usage)
    if (len(options%folder) == 0) options%folder = default_folder(options%deck)

  contains

    subroutine set_folder(name)
      character(*), intent(in) :: name

      if (len(name) == 0 .or. name(1:min(1, len(name))) == '-') then
        call log%add_error(command_line_place(), '', &
          '--out needs the name of a folder, found ' // quoted(name), '')
      else if (len(options%folder) > 0) then
        call log%add_error(command_line_place(), '', '--out is given twice', '')
      else
        options%folder = name
      end if
    end subroutine set_folder

    subroutine add_setting(name, text)
      character(*), intent(in) :: name, text
      type(setting), allocatable :: longer(:)

      if (len_trim(text) == 0) then
        call log%add_error(command_line_place(), '', quoted(name // '=') // ' has no value', &
          'There are no blanks around the =.')
        return
      end if
      do k = 1, size(options%settings)
        if (lower_case(options%settings(k)%name) /= lower_case(name)) cycle
        call log%add_error(command_line_place(), '', quoted(name) // ' is set twice', '')
        return
      end do
      allocate (longer(size(options%settings)+1))
      do k = 1, size(options%settings)
        longer(k) = options%settings(k)
      end do
      longer(size(longer))%name = name
      longer(size(longer))%text = text
      call move_alloc(longer, options%settings)
    end subroutine add_setting
  end subroutine parse_arguments

  pure function default_folder(deck) result(folder)
    !! NAME.out, beside where the command was given.
    character(*), intent(in) :: deck
    character(:), allocatable :: folder
    integer :: point

    folder = deck(index(deck, '/', back=.true.)+1:)
    point = index(folder, '.', back=.true.)
    if (point > 1) folder = folder(1:point-1)
    folder = folder // '.out'
  end function default_folder

  function usage_text() result(text)
    character(:), allocatable :: text            !! for --help, lines separated by line feeds
    character, parameter :: nl = new_line('a')

    text = 'bezel DECK [name=value ...] [--out DIR]' // nl // &
      'bezel --check MESH' // nl // nl // &
      'Solves the problem that the text file DECK describes.' // nl // nl // &
      '  name=value   sets a parameter of the deck, a number or a word' // nl // &
      '  --out DIR    folder of the results instead of NAME.out' // nl // &
      '  --check      reads and verifies the deck, prints what it holds, runs nothing;' // nl // &
      '               the same for a mesh of extraction operators (.iga, BEXT, .h5)' // nl // &
      '  --restart    continues from the result folder' // nl // &
      '  --help       prints this' // nl // &
      '  --version    prints the version' // nl // nl // &
      'Exit status: 0 all steps done, 1 the solution failed (the last good state is on disk),' // &
        nl // &
      '2 the deck or the command line is wrong, 3 a file or the machine failed.'
  end function usage_text
end module command_line
