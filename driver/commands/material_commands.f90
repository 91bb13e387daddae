module material_commands
  !! MATErial: an element type and its law data.
  !!
  !!     MATErial 1 rubber
  !!       SOLId
  !!       ELAStic NEOHook 1.0 0.3
  !!       PLANe STRAin
  !!
  !! The lines mean something to the element alone: it reads them by its `define`.
  use messages, only: message_log, deck_place, whole_text, quoted, in_place
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type, material_type
  use user_element, only: element_type, property_record
  use element_library, only: new_element
  use data_lines, only: next_line, as_property
  implicit none (type, external)
  private
  public :: read_material, read_properties, define_element

contains

  subroutine read_material(deck, command, model, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(message_log), intent(inout) :: log
    type(material_type), allocatable :: larger(:)
    type(property_record), allocatable :: properties(:)
    type(deck_place), allocatable :: places(:)
    type(record) :: rec
    class(element_type), allocatable :: element
    character(:), allocatable :: known
    character(4) :: keyword
    integer :: i, n, number
    logical :: more

    call command%integer(2, number, log, 'number of the material')
    do i = 1, size(model%materials)
      if (model%materials(i)%number == number) call command%add_error(log, 'material ' // &
        whole_text(number) // &
        ' is defined twice', 'The first stands in ' // model%materials(i)%place)
    end do
    allocate (properties(0), places(0))
    keyword = ''
    call next_line(deck, rec, log, more)
    if (.not. more) then
      call command%add_error(log, 'the material has no element type', &
        'The first line is SOLId for example')
    else
      keyword = rec%key(1)
      call new_element(keyword, element, known)
      if (keyword == 'gpts' .and. allocated(element)) deallocate (element)  ! CONTact makes it, no element of a mesh is one
      if (.not. allocated(element)) call rec%add_error(log, 'unknown element type ' // &
        quoted(rec%word(1)), &
        'Known element types: ' // known, 1)
      if (rec%count > 1) then
        allocate (properties(1))
        call as_property(rec, 1, properties(1), log)
        places = [rec%at]
      end if
      call read_properties(deck, properties, places, .false., log)
    end if
    call define_element(element, model%ndm, 'MATErial', command%at, properties, places, log)
    if (allocated(element)) then
      if (element%ndf > model%ndf) call command%add_error(log, 'the element has ' // &
        whole_text(element%ndf) // &
        ' dofs per node', 'Write at least this number as ndf, the fifth number after FEAP')
    end if

    n = size(model%materials)
    allocate (larger(n + 1))
    do i = 1, n
      larger(i)%number = model%materials(i)%number
      call move_alloc(model%materials(i)%name, larger(i)%name)
      call move_alloc(model%materials(i)%place, larger(i)%place)
      call move_alloc(model%materials(i)%element, larger(i)%element)
    end do
    larger(n + 1)%number = number
    call command%text(3, larger(n + 1)%name, log, 'name', '')
    larger(n + 1)%place = in_place(command%at)
    call move_alloc(element, larger(n + 1)%element)
    call move_alloc(larger, model%materials)
  end subroutine read_material

  subroutine read_properties(deck, properties, places, may_end, log)
    !! Lines of law data to the end of the data set.
    type(deck_type), intent(inout) :: deck
    type(property_record), allocatable, intent(inout) :: properties(:)   !! appended to
    type(deck_place), allocatable, intent(inout) :: places(:)            !! of each
    logical, intent(in) :: may_end           !! a command may follow without blank line
    type(message_log), intent(inout) :: log
    type(property_record) :: property
    type(record) :: rec
    logical :: more

    do
      call next_line(deck, rec, log, more, may_end)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      call as_property(rec, 1, property, log)
      properties = [properties, property]
      places = [places, rec%at]
    end do
  end subroutine read_properties

  subroutine define_element(element, ndm, command, at, properties, places, log)
    !! Hand the law data to the element; its fault is shown at the line that it names.
    class(element_type), allocatable, intent(inout) :: element
    integer, intent(in) :: ndm
    character(*), intent(in) :: command
    type(deck_place), intent(in) :: at                 !! of the command
    type(property_record), intent(in) :: properties(:)
    type(deck_place), intent(in) :: places(:)
    type(message_log), intent(inout) :: log
    character(:), allocatable :: fault
    integer :: bad_record

    if (.not. allocated(element)) return
    call element%define(ndm, properties, fault, bad_record)
    if (.not. allocated(fault)) return
    if (bad_record >= 1 .and. bad_record <= size(places)) then
      call log%add_error(places(bad_record), command, fault, '')
    else
      call log%add_error(at, command, fault, '')
    end if
  end subroutine define_element
end module material_commands
