module data_lines
  !! Lines of the data sets of mesh commands: where a set ends, items that are a name or a number,
  !! law data.
  use kinds, only: wp
  use messages, only: message_log, string, lower_case, quoted, in_place
  use expressions, only: value, number_value, word_value
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use user_element, only: property_record
  implicit none (type, external)
  private
  public :: next_line, name_or_number, node_or_set, as_property, mesh_command, mesh_commands_known

  character(16), parameter :: mesh_commands_known(28) = [character(16) :: 'COORdinates', &
    'ELEMents', 'OPERator', &
    'BEZIer', 'PATCh', 'MERGe', 'T-SPline', 'QUADmesh', 'TIE', 'SET', 'MATErial', 'BOUNdary', 'DISPlacement', 'FORCe', &
    'FPROportional', &
    'PROPortional', 'SLOAd', 'LINK', 'ENDFace', 'CLAMp', 'SYMMetry', 'JOINt', &
    'CONTact', 'HISTory', 'OUTPut', 'RESTart', 'EXPOrt', 'END']

contains

  pure integer function mesh_command(word)
    !! Index of the mesh command that a word is (its first four letters, or more of them); 0 if it
    !! is none.
    character(*), intent(in) :: word
    integer :: i, n

    do i = 1, size(mesh_commands_known)
      n = len_trim(mesh_commands_known(i))
      if (len(word) > n .or. len(word) < min(4, n)) cycle
      if (lower_case(word) == lower_case(mesh_commands_known(i)(1:len(word)))) then
        mesh_command = i
        return
      end if
    end do
    mesh_command = 0
  end function mesh_command

  subroutine next_line(deck, rec, log, more, may_end, names)
    !! The next line of a data set. A mesh command ends the set as a blank line does; unless it is
    !! END, with a message: the blank line is missing.
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    type(message_log), intent(inout) :: log
    logical, intent(out) :: more                 !! .false.: the set has ended
    logical, intent(in), optional :: may_end     !! a command may follow without blank line
    type(string), intent(in), optional :: names(:)  !! of sets that a line may begin with
    logical :: silent
    integer :: i

    call deck%next_record(rec, log)
    more = .not. rec%ends_set
    if (.not. more) return
    if (rec%is_quoted(1)) return
    if (mesh_command(rec%word(1)) == 0) return
    if (present(names)) then
      do i = 1, size(names)
        if (names(i)%s == rec%word(1)) return
      end do
    end if
    more = .false.
    silent = rec%key(1) == 'end'
    if (present(may_end)) silent = may_end
    if (.not. silent) call rec%add_error(log, 'the data set is not ended before ' // &
      quoted(rec%word(1)), &
      'Put a blank line before it (a set of that name is written in quotes)')
    call deck%push_back(rec)
  end subroutine next_line

  subroutine name_or_number(rec, i, v, log)
    !! An item that is a number, a parameter or a plain name; the latter two may be words.
    type(record), intent(in) :: rec
    integer, intent(in) :: i
    type(value), intent(out) :: v                !! unknown after an error
    type(message_log), intent(inout) :: log
    type(message_log) :: unheard
    character(:), allocatable :: word

    word = rec%word(i)
    call rec%item_value(i, v, unheard, 'a number', 'this item')
    if (v%kind == number_value .or. v%kind == word_value) return
    if (unheard%error_count() == 0) return       ! a parameter whose own error was reported
    if (is_plain_name(word)) then
      v%kind = word_value
      v%word = word
    else
      call rec%item_value(i, v, log, 'a name or a number', 'item')
    end if
  end subroutine name_or_number

  pure logical function is_plain_name(word)
    !! Begins with a letter and holds no operators (a dot is part of the names of surfaces).
    character(*), intent(in) :: word
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz_'

    is_plain_name = .false.
    if (len(word) == 0) return
    if (scan(lower_case(word(1:1)), letters) == 0) return
    is_plain_name = verify(lower_case(word), letters // '0123456789.-') == 0
  end function is_plain_name

  subroutine node_or_set(rec, i, is_node, node, set, log)
    type(record), intent(in) :: rec
    integer, intent(in) :: i
    logical, intent(out) :: is_node
    integer, intent(out) :: node                       !! 0 for a set or after an error
    character(:), allocatable, intent(out) :: set      !! '' for a node or after an error
    type(message_log), intent(inout) :: log
    type(value) :: v

    node = 0
    set = ''
    is_node = .false.
    call name_or_number(rec, i, v, log)
    if (v%kind == word_value) then
      set = v%word
    else if (v%kind == number_value) then
      is_node = .true.
      call rec%integer(i, node, log, 'node number')
    end if
  end subroutine node_or_set

  subroutine as_property(rec, first, property, log)
    !! A line of law data: words by their first four letters, numbers and parameters.
    type(record), intent(in) :: rec
    integer, intent(in) :: first                       !! item that counts first
    type(property_record), intent(out) :: property
    type(message_log), intent(inout) :: log
    type(value) :: v
    integer :: i

    property%place = in_place(rec%at)
    allocate (property%words(0), property%values(0))
    do i = first, rec%count
      if (rec%is_named(i) .or. (i == first .and. is_plain_name(rec%word(i)))) then
        property%words = [property%words, rec%key(i)]
        cycle
      end if
      call name_or_number(rec, i, v, log)
      if (v%kind == number_value) then
        property%values = [property%values, v%x]
      else if (v%kind == word_value) then
        property%words = [property%words, four_letters(v%word)]
      end if
    end do
  end subroutine as_property

  pure function four_letters(word) result(key)
    character(*), intent(in) :: word
    character(4) :: key

    key = lower_case(word(1:min(4, len(word))))
  end function four_letters
end module data_lines
