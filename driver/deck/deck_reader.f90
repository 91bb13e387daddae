module deck_reader
  !! A deck, record by record. The commands of a mesh or a solution are read by others, on top of
  !! this:
  !!
  !!     type(deck) :: input
  !!     type(record) :: rec
  !!     call input%open('ironing.inp', settings, log)    ! name=value of the command line
  !!     do
  !!       call input%next_command(rec, log)              ! skips blank lines; messages name it
  !!       if (rec%end_of_deck) exit
  !!       select case (rec%key(1))                         ! four letters, lower case
  !!       case ('coor')
  !!         do
  !!           call input%next_record(rec, log)
  !!           if (rec%ends_set) exit                       ! blank line or end of deck
  !!           call rec%integer(1, id, log, 'node number')
  !!           call rec%numbers(3, x(1:ndm), log, 'coordinates')
  !!         end do
  !!       case default
  !!         call input%refuse_command(rec, [character(11) :: 'COORdinates', ...], log)
  !!       end select
  !!     end do
  !!     call input%finish(log)                           ! unknown settings, IF without ENDIf
  !!     if (log%error_count() > 0) ...
  !!
  !! (access to the items of a record: module deck_record). `push_back` gives a record back, to be
  !! read again; `skip_set` goes on behind the next blank line. `title`, `full_text`,
  !! `parameters%count, name(i), text(i)` tell what was read; `place(order)` finds file and line of
  !! a record of which only `rec%at%order` was kept.
  !!
  !! Handled here, and never seen by the commands, wherever they stand (also inside data sets and
  !! included files):
  !!
  !!     FEAP * * title          the first line that is neither blank nor a comment
  !!     PARAmeter, TABLe        see module parameters; to a blank line
  !!     INCLude file            relative to the including file; quotes hold blanks, commas, =
  !!     IF expr / ELSEif expr / ELSE / ENDIf     expr is the rest of the line: basis == "L"
  !!     LOOP n [i] / NEXT       repeats the lines between them, i counts from 1; before BATCh only,
  !!                             behind it LOOP and NEXT are solution commands and come as records
  !!     {expr}                  anywhere in a line: replaced by the value before all else (whole
  !!                             numbers without point); not in comments and the title
  !!     INTEractive             refused
  !!
  !! The first four letters count, in any case (all letters of IF, ELSE, END). A line that begins
  !! with such a word and goes on with `=` is not that command (`loops = 3`); a name in quotes never
  !! is. An IF or LOOP ends in the file in which it begins. After an error the reader goes on; a
  !! condition with an error counts as false.
  use kinds, only: wp
  use messages, only: string, deck_place, message_log, name_hint, closest_name, lower_case, &
    quoted, in_place, edit_distance
  use number_text, only: equal
  use expressions, only: symbol_source, value, expression_problem, evaluate, value_text, &
    number_value, word_value
  use command_words, only: control_word, command_form
  use logical_lines, only: logical_line, blank_line
  use deck_record, only: record
  use deck_source, only: source, line_read, deck_ended
  use deck_substitution, only: substitute
  use deck_blocks, only: control_block, block_stack, if_block, loop_block
  use parameters, only: deck_parameters, setting, command_line_place
  implicit none (type, external)
  private
  public :: deck, record, setting

  type :: deck
    character(:), allocatable :: title
    character(:), allocatable :: path
    type(deck_parameters), pointer :: parameters => null()
    class(symbol_source), pointer, private :: symbols => null()   ! the same
    type(source), private :: text
    type(block_stack), private :: blocks
    logical, private :: in_solution = .false.
    logical, private :: at_end = .false.
    logical, private :: line_damaged = .false.
    logical, private :: is_held = .false.
    type(record), private :: held                ! given back
    type(record), private :: control             ! items of INCLude and LOOP
    type(logical_line), private :: scratch
    character(:), allocatable, private :: command
  contains
    procedure :: open => open_deck
    procedure :: next_command
    procedure :: next_record
    procedure :: push_back
    procedure :: skip_set
    procedure :: refuse_command
    procedure :: finish
    procedure :: close => close_deck
    procedure :: place
    procedure :: full_text
    procedure, private :: next_text
    procedure, private :: read_parameters
    procedure, private :: read_table
    procedure, private :: begin_if
    procedure, private :: next_branch
    procedure, private :: begin_loop
    procedure, private :: next_pass
    procedure, private :: include
    procedure, private :: condition
  end type deck

contains

  subroutine open_deck(self, path, settings, log)
    class(deck), intent(inout) :: self
    character(*), intent(in) :: path             !! the deck
    type(setting), intent(in) :: settings(:)     !! name=value of the command line
    type(message_log), intent(inout) :: log
    type(logical_line) :: line
    type(deck_place) :: at
    character(:), allocatable :: word
    integer :: outcome

    allocate (self%parameters)
    self%symbols => self%parameters
    call self%parameters%start(settings)
    self%path = path
    self%title = ''
    self%command = ''
    call self%text%open(path, command_line_place(), log)
    self%at_end = self%text%nesting() == 0
    if (self%at_end) return
    do
      call self%text%next_line(line, outcome, log)
      if (outcome == deck_ended) then
        at%file = path
        call log%add_error(at, '', 'the deck is empty', 'It begins with "FEAP * * title".')
        self%at_end = .true.
        return
      end if
      if (line%n > 0) exit
    end do
    word = lower_case(line%text(1:scan(line%text(1:line%n) // ' ', ' *,') - 1))
    if (word(1:min(4, len(word))) == 'feap') then
      self%title = line%text(min(5, line%n + 1):line%n)
      do while (verify(self%title, '* ') > 1)
        self%title = self%title(verify(self%title, '* '):)
      end do
      if (verify(self%title, '* ') == 0) self%title = ''
    else
      call log%add_error(line%at, '', 'the deck begins with ' // quoted(line%text(1:line%n)), &
        'Its first line must be "FEAP * * title".')
      ! a misspelt word is one error, another kind of file would give thousands
      self%at_end = edit_distance(word, 'feap') > 2
    end if
  end subroutine open_deck

  subroutine next_command(self, rec, log)
    !! The next record that is not blank. Messages name it until the next call.
    class(deck), intent(inout) :: self
    type(record), intent(inout) :: rec
    type(message_log), intent(inout) :: log

    self%command = ''
    do
      call self%next_record(rec, log)
      if (rec%end_of_deck) return
      if (.not. rec%is_blank) exit
    end do
    self%command = command_form(rec%word(1))
    rec%command = self%command
  end subroutine next_command

  subroutine next_record(self, rec, log)
    class(deck), intent(inout) :: self
    type(record), intent(inout) :: rec
    type(message_log), intent(inout) :: log
    character(4) :: word
    logical :: in_hand

    if (self%is_held) then
      rec = self%held
      self%is_held = .false.
      return
    end if
    in_hand = .false.
    do
      if (.not. in_hand) call self%next_text(rec%line, word, log)
      in_hand = .false.
      rec%is_damaged = self%line_damaged
      rec%command = self%command
      if (self%at_end) then
        call blank_line(rec%line)
        call rec%split(self%symbols, log)
        rec%end_of_deck = .true.
        return
      end if
      call rec%split(self%symbols, log)
      select case (word)
      case ('para')
        call self%read_parameters(rec, word, in_hand, log)
      case ('tabl')
        call self%read_table(rec, log)
      case default
        return
      end select
    end do
  end subroutine next_record

  subroutine push_back(self, rec)
    !! The next record will be this one again.
    class(deck), intent(inout) :: self
    type(record), intent(in) :: rec

    self%held = rec
    self%is_held = .true.
  end subroutine push_back

  subroutine skip_set(self, rec, log)
    !! Goes on behind the next blank line.
    class(deck), intent(inout) :: self
    type(record), intent(inout) :: rec           !! afterwards the blank one
    type(message_log), intent(inout) :: log

    do while (.not. rec%ends_set)
      call self%next_record(rec, log)
    end do
  end subroutine skip_set

  subroutine refuse_command(self, rec, names, log)
    !! Reports a command that nobody knows, and goes on behind its data set.
    class(deck), intent(inout) :: self
    type(record), intent(inout) :: rec
    character(*), intent(in) :: names(:)         !! the commands that can stand here: COORdinates
    type(message_log), intent(inout) :: log
    type(string) :: keys(size(names))
    character(:), allocatable :: hint
    integer :: i

    do i = 1, size(names)
      keys(i)%s = names(i)(1:min(4, len(names)))
    end do
    i = closest_name(trim(rec%key(1)), keys)
    if (i > 0) then
      hint = 'Did you mean "' // trim(names(i)) // '"?'
    else
      hint = name_hint(rec%word(1), names, 'commands')
    end if
    rec%command = ''
    call rec%add_error(log, 'there is no command ' // quoted(rec%word(1)) // ' here', hint)
    call self%skip_set(rec, log)
  end subroutine refuse_command

  subroutine finish(self, log)
    !! To be called where reading ends (end of the deck or STOP).
    class(deck), intent(inout) :: self
    type(message_log), intent(inout) :: log
    type(logical_line) :: line
    character(4) :: word

    do while (self%blocks%count > 0 .and. .not. self%at_end)
      call self%next_text(line, word, log)
    end do
    call self%parameters%check_settings(log)
  end subroutine finish

  subroutine close_deck(self)
    !! Gives the parameters' memory back; records of this deck are no longer of use.
    class(deck), intent(inout) :: self

    if (associated(self%parameters)) deallocate (self%parameters)
    nullify (self%symbols)
  end subroutine close_deck

  function place(self, order) result(at)
    class(deck), intent(in) :: self
    integer, intent(in) :: order                 !! rec%at%order of a record
    type(deck_place) :: at

    at = self%text%place(order)
  end function place

  function full_text(self) result(text)
    class(deck), intent(in) :: self
    character(:), allocatable :: text            !! the deck, then the included files
    integer :: i

    text = ''
    do i = 1, self%text%file_count()
      if (i > 1) text = text // new_line('a') // '! ---- ' // self%text%file_name(i) // &
        ' ----' // new_line('a')
      text = text // self%text%file_text(i)
    end do
  end function full_text

  subroutine next_text(self, line, word, log)
    !! The next line that is read, after substitution; follows IF, LOOP and INCLude. Sets at_end.
    class(deck), intent(inout) :: self
    type(logical_line), intent(inout) :: line
    character(4), intent(out) :: word            !! the word of control that it begins with, else ''
    type(message_log), intent(inout) :: log
    integer :: outcome

    word = ''
    self%line_damaged = .false.
    do while (.not. self%at_end)
      call self%text%next_line(line, outcome, log)
      if (outcome /= line_read) then
        call self%blocks%close(self%text%nesting(), log)
        self%at_end = outcome == deck_ended
        cycle
      end if
      word = control_word(line%text(1:line%n))
      select case (word)
      case ('if')
        call self%begin_if(line, log)
        cycle
      case ('elif', 'else', 'endi')
        call self%next_branch(line, word, log)
        cycle
      case ('loop', 'next')
        if (.not. self%in_solution) then
          if (word == 'loop') call self%begin_loop(line, log)
          if (word == 'next') call self%next_pass(line, log)
          cycle
        end if
      end select
      if (.not. self%blocks%active) cycle
      call substitute(line, self%symbols, self%scratch, self%line_damaged, log)
      word = control_word(line%text(1:line%n))
      select case (word)
      case ('incl')
        call self%include(line, log)
        cycle
      case ('inte')
        call log%add_error(line%at, 'INTEractive', 'there is no interactive mode', &
          'Write the solution commands between BATCh and END.')
        cycle
      case ('batc')
        self%in_solution = .true.
      case ('end')
        self%in_solution = .false.
      end select
      return
    end do
  end subroutine next_text

  subroutine read_parameters(self, rec, word, in_hand, log)
    class(deck), intent(inout) :: self
    type(record), intent(inout) :: rec           !! the record PARAmeter
    character(4), intent(out) :: word            !! control word of the line in hand
    logical, intent(out) :: in_hand              !! rec%line is not a parameter, but what comes next
    type(message_log), intent(inout) :: log

    rec%command = 'PARAmeter'
    if (rec%count > 1) call rec%add_error(log, quoted(rec%rest(2)) // ' is unexpected', &
      'Parameters stand on lines of their own, name = value, to a blank line.')
    self%text%keep_comments = .true.
    in_hand = .false.
    do
      call self%next_text(rec%line, word, log)
      if (self%at_end) exit
      if (rec%line%n == 0) exit
      if (index(rec%line%text(1:rec%line%n), '=') == 0) then
        call log%add_error(rec%line%at, 'PARAmeter', 'expected name = value, found ' // &
          quoted(rec%line%text(1:rec%line%n)), 'A blank line ends the parameters.')
        in_hand = .true.
        exit
      end if
      if (.not. allocated(rec%line%comment)) rec%line%comment = ''
      call self%parameters%assign(rec%line%text(1:rec%line%n), rec%line%comment, &
        self%line_damaged, &
        rec%line%at, log)
    end do
    self%text%keep_comments = .false.
  end subroutine read_parameters

  subroutine read_table(self, rec, log)
    class(deck), intent(inout) :: self
    type(record), intent(inout) :: rec           !! the record TABLe name
    type(message_log), intent(inout) :: log
    character(4) :: word

    rec%command = 'TABLe'
    call rec%check_count(2, 2, log, 'TABLe name')
    call self%parameters%begin_table(rec%word(2), rec%at, log)
    do
      call self%next_text(rec%line, word, log)
      if (self%at_end) return
      rec%is_damaged = self%line_damaged
      call rec%split(self%symbols, log)
      if (rec%is_blank) return
      call self%parameters%add_table_line(rec, log)
    end do
  end subroutine read_table

  subroutine include(self, line, log)
    class(deck), intent(inout) :: self
    type(logical_line), intent(in) :: line
    type(message_log), intent(inout) :: log

    self%control%line = line
    self%control%command = 'INCLude'
    self%control%is_damaged = self%line_damaged
    call self%control%split(self%symbols, log)
    if (self%control%is_damaged) return
    call self%control%check_count(2, 2, log, 'INCLude file')
    if (self%control%count == 2) call self%text%include(self%control%word(2), line%at, log)
  end subroutine include

  subroutine begin_if(self, line, log)
    class(deck), intent(inout) :: self
    type(logical_line), intent(inout) :: line
    type(message_log), intent(inout) :: log
    type(control_block) :: block

    block%kind = if_block
    block%outer_active = self%blocks%active
    block%active = self%blocks%active
    if (self%blocks%active) block%active = self%condition(line, 'IF', log)
    block%taken = block%active
    call self%blocks%push(block, self%text%nesting(), line%at)
  end subroutine begin_if

  subroutine next_branch(self, line, word, log)
    !! ELSEif, ELSE and ENDIf.
    class(deck), intent(inout) :: self
    type(logical_line), intent(inout) :: line
    character(4), intent(in) :: word
    type(message_log), intent(inout) :: log
    character(:), allocatable :: command
    logical :: holds

    command = 'ENDIf'
    if (word == 'else') command = 'ELSE'
    if (word == 'elif') command = 'ELSEif'
    if (.not. self%blocks%find(if_block, self%text%nesting(), command, line%at, log)) return
    if (word == 'endi') then
      call self%blocks%pop()
      return
    end if
    holds = .true.
    associate (block => self%blocks%list(self%blocks%count))
      if (block%has_else) call log%add_error(line%at, command, &
        'the IF at ' // in_place(block%at) // ' has its ELSE already', '')
      if (word == 'else' .and. line%n > len('ELSE')) call log%add_error(line%at, command, &
        quoted(trim(adjustl(line%text(5:line%n)))) // ' is unexpected', &
          'Another condition needs ELSEif.')
      block%has_else = block%has_else .or. word == 'else'
      if (block%taken) holds = .false.
      if (holds .and. block%outer_active .and. word == 'elif') &
        holds = self%condition(line, command, log)
      block%active = holds .and. block%outer_active
      block%taken = block%taken .or. holds
      self%blocks%active = block%active
    end associate
  end subroutine next_branch

  logical function condition(self, line, command, log)
    class(deck), intent(inout) :: self
    type(logical_line), intent(inout) :: line
    character(*), intent(in) :: command
    type(message_log), intent(inout) :: log
    type(expression_problem) :: problem
    type(value) :: v
    integer :: first

    condition = .false.
    self%line_damaged = .false.
    call substitute(line, self%symbols, self%scratch, self%line_damaged, log)
    if (self%line_damaged) return
    first = len('IF') + 1
    if (command == 'ELSEif') first = index(lower_case(line%text(1:line%n)), 'if') + len('IF')
    call evaluate(trim(adjustl(line%text(first:line%n))), self%symbols, v, problem)
    if (problem%found) then
      if (len(problem%name) > 0) problem%remedy = 'A word is written in quotes, "' // &
        problem%name // '". ' // &
        problem%remedy
      call log%add_error(line%at, command, problem%fact, problem%remedy)
    else if (v%kind == word_value) then
      call log%add_error(line%at, command, 'expected a condition, found the word ' // &
        quoted(v%word), '')
    else if (v%kind == number_value) then
      condition = .not. equal(v%x, 0.0_wp)
    end if
  end function condition

  subroutine begin_loop(self, line, log)
    class(deck), intent(inout) :: self
    type(logical_line), intent(inout) :: line
    type(message_log), intent(inout) :: log
    type(control_block) :: block
    type(value) :: v

    block%kind = loop_block
    block%outer_active = self%blocks%active
    block%active = self%blocks%active
    block%counter = ''
    if (.not. self%blocks%active) then
      if (self%blocks%loop_is_skipped()) call self%blocks%push(block, self%text%nesting(), line%at)
      return
    end if
    self%line_damaged = .false.
    call substitute(line, self%symbols, self%scratch, self%line_damaged, log)
    self%control%line = line
    self%control%command = 'LOOP'
    self%control%is_damaged = self%line_damaged
    call self%control%split(self%symbols, log)
    call self%control%check_count(2, 3, log, 'LOOP number [counter]')
    call self%control%item_value(2, v, log, 'a whole number', 'the passes')
    if (v%kind == word_value) then
      call self%control%add_error(log, &
        'expected a whole number for the passes, found the word ' // quoted(v%word), '')
    else if (v%kind == number_value) then
      if (v%x >= 0 .and. v%x < huge(1) .and. equal(aint(v%x), v%x)) then
        block%passes = nint(v%x)
      else
        call self%control%add_error(log, 'expected a whole number for the passes, found ' // &
          value_text(v), '')
      end if
    end if
    block%active = block%passes > 0
    block%counter = self%control%word(3)
    if (len(block%counter) > 0 .and. block%active) &
      call self%parameters%set_counter(block%counter, 1, line%at, log)
    block%begin = self%text%mark()
    call self%blocks%push(block, self%text%nesting(), line%at)
  end subroutine begin_loop

  subroutine next_pass(self, line, log)
    class(deck), intent(inout) :: self
    type(logical_line), intent(in) :: line
    type(message_log), intent(inout) :: log

    if (.not. self%blocks%active) then
      if (.not. self%blocks%loop_is_skipped()) return
    end if
    if (.not. self%blocks%find(loop_block, self%text%nesting(), 'NEXT', line%at, log)) return
    associate (block => self%blocks%list(self%blocks%count))
      if (block%active .and. block%pass < block%passes) then
        block%pass = block%pass + 1
        if (len(block%counter) > 0) &
          call self%parameters%set_counter(block%counter, block%pass, block%at, log)
        call self%text%return_to(block%begin)
        return
      end if
    end associate
    call self%blocks%pop()
  end subroutine next_pass
end module deck_reader
